#include "software.hpp"

#include <algorithm>

namespace metier::virtual_edo {

Result<Software> Software::find(std::string_view version) {
    static const std::vector<Software> kReleases{
        {.version = "2.4.0", .external_control = false, .residuals = false},
        {.version = "3.0.1", .external_control = false, .residuals = true},
        {.version = "3.1.2", .external_control = true, .residuals = true},
        {.version = "3.2.0", .external_control = true, .residuals = true},
    };
    const auto release = std::ranges::find(kReleases, version, &Software::version);
    if (release != kReleases.end()) {
        return *release;
    }
    return fail(Errc::not_found, fmt::format("'{}' is no release; there are 2.4.0, 3.0.1, 3.1.2 "
                                             "and 3.2.0",
                                             version));
}

}  // namespace metier::virtual_edo
