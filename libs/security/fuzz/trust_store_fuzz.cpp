// Fuzzes files in the folders of a store: revocation lists and certificates that anybody put there.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "stores.hpp"

namespace {

using namespace metier::security;
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
    static const metier::fuzz::Scratch scratch("trust_store_fuzz");
    static const auto own_folder =
        metier::security::fuzz::storeOfAnAuthority(scratch.path()).folder();
    static const auto peer = signedCertificate();
    static const std::array places{
        own_folder / "trusted/crl/input", own_folder / "issuers/certs/input",
        own_folder / "trusted/certs/input", own_folder / "issuers/crl/input"};
    if (size == 0) {
        return 0;
    }
    const auto& place = places.at(data[0] % places.size());
    put(place, {reinterpret_cast<const char*>(data) + 1, size - 1});
    auto store = TrustStore::open(own_folder);
    if (!store) {
        std::abort();
    }
    const auto checked = store->check(peer, metier::security::fuzz::kNow);
    if (!checked && checked.error().message.empty()) {
        std::abort();
    }
    static_cast<void>(store->addRevocationList(place));
    static_cast<void>(store->trusted());
    fs::remove(place);
    return 0;
}
