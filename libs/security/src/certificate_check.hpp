#pragma once

#include "holdings.hpp"
#include "metier/security/trust_store.hpp"

namespace metier::security {

/// Checks that a certificate is trusted, strong enough, meant for this use and valid at this time.
tl::expected<void, CertificateRefusal> checkCertificate(const Certificate& certificate,
                                                        const TrustStore::Holdings& holdings,
                                                        UtcTime now);

}  // namespace metier::security
