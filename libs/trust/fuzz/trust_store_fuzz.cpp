// Files in the folders of a store: revocation lists and certificates that somebody put there.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "stores.hpp"

namespace {

using namespace metier::trust;
namespace fs = std::filesystem;

std::string signedCertificate() {
    std::ifstream file(fs::path(METIER_TRUST_SEEDS) / "signed.der", std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

void put(const fs::path& file, std::string_view content) {
    std::ofstream(file, std::ios::binary | std::ios::trunc) << content;
}

}  // namespace

/// The first byte says which folder the rest is in.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const metier::fuzz::Scratch kScratch("trust_store_fuzz");
    static const auto kFolder = metier::trust::fuzz::storeOfAnAuthority(kScratch.path()).folder();
    static const auto kPeer = signedCertificate();
    static const std::array kPlaces{kFolder / "trusted/crl/input", kFolder / "issuers/certs/input",
                                    kFolder / "trusted/certs/input", kFolder / "issuers/crl/input"};
    if (size == 0) {
        return 0;
    }
    const auto& place = kPlaces.at(data[0] % kPlaces.size());
    put(place, {reinterpret_cast<const char*>(data) + 1, size - 1});
    auto store = TrustStore::open(kFolder);
    if (!store) {
        std::abort();
    }
    const auto checked = store->check(kPeer, metier::trust::fuzz::kNow);
    if (!checked && checked.error().message.empty()) {
        std::abort();
    }
    static_cast<void>(store->addRevocationList(place));
    static_cast<void>(store->trusted());
    fs::remove(place);
    return 0;
}
