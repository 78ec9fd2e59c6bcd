#pragma once

#include <chrono>
#include <cstdlib>
#include <filesystem>

#include "metier/security/trust_store.hpp"
#include "scratch.hpp"

namespace metier::security::fuzz {

namespace fs = std::filesystem;

/// The seeds are valid then.
inline const UtcTime kNow = std::chrono::sys_days(std::chrono::year(2030) / 1 / 1);

/// One in `folder` that trusts the authority of the seeds, whose revocation list it has.
inline TrustStore storeOfAnAuthority(const fs::path& folder) {
    auto store = TrustStore::open(folder);
    if (!store) {
        std::abort();
    }
    const fs::path seeds(METIER_TRUST_SEEDS);
    fs::copy_file(seeds / "authority.der", folder / "trusted/certs/authority.der");
    fs::copy_file(seeds / "list.der", folder / "trusted/crl/list.der");
    return std::move(*store);
}

}  // namespace metier::security::fuzz
