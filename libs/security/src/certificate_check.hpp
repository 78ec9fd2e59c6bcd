#pragma once

#include "holdings.hpp"
#include "metier/security/trust_store.hpp"

namespace metier::security {

/// Whether a certificate is trusted, strong enough, for the right use, and in its time.
tl::expected<void, CertificateRefusal> checkCertificate(const Certificate& certificate,
                                                        const TrustStore::Holdings& holdings,
                                                        UtcTime now);

}  // namespace metier::security
