// Fuzzes the certificate of a peer, checked by a store that trusts an authority.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "metier/security/trust_store.hpp"
#include "stores.hpp"

namespace {

using namespace metier::security;

bool isPrintable(const std::string& text) {
    return std::none_of(text.begin(), text.end(), [](char character) {
        return static_cast<unsigned char>(character) < ' ' || character == '\x7f';
    });
}

/// Checks that an accepted certificate can be printed, compared and parsed again.
void use(const Certificate& certificate, std::string_view sent) {
    const auto again = Certificate::fromDer(certificate.der());
    const bool told = isPrintable(certificate.subject()) && isPrintable(certificate.issuer()) &&
                      isPrintable(certificate.applicationUri());
    if (!again || !(*again == certificate) || !told || !sent.starts_with(certificate.der()) ||
        certificate.thumbprint() != thumbprintOf(certificate.der())) {
        std::abort();
    }
    static_cast<void>(certificate.pem());
    static_cast<void>(dateText(certificate.notAfter()));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const metier::fuzz::Scratch folder("certificate_fuzz");
    static auto store = metier::security::fuzz::storeOfAnAuthority(folder.path());
    const std::string_view sent(reinterpret_cast<const char*>(data), size);
    if (const auto certificate = Certificate::fromDer(sent)) {
        use(*certificate, sent);
    }
    const auto checked = store.check(sent, metier::security::fuzz::kNow);
    if (!checked && (checked.error().message.empty() || !isPrintable(checked.error().message))) {
        std::abort();
    }
    return 0;
}
