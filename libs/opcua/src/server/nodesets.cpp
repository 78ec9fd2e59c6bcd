#include "server/nodesets.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "metier/nodesets/nodesets.h"
#include "metier/opcua/status_code.hpp"
#include "metier/opcua/text.hpp"

namespace metier::opcua {

namespace {

struct Nodeset {
    std::string_view name;
    UA_StatusCode (*load)(UA_Server*);
};

/// NodeSets that all of ours need, in the order of loading.
constexpr std::array kModel{
    Nodeset{"di", namespace_di_generated},
    Nodeset{"ia", namespace_ia_generated},
    Nodeset{"rob", namespace_rob_generated},
    Nodeset{"device", namespace_device_generated},
    Nodeset{"robotics", namespace_robotics_generated},
    Nodeset{"metier", namespace_metier_generated},
};

constexpr std::array kInstances{
    Nodeset{"iiwa", namespace_iiwa_generated},
    Nodeset{"edo", namespace_edo_generated},
    Nodeset{"universal_robots", namespace_universal_robots_generated},
    Nodeset{"wsg50", namespace_wsg50_generated},
};

bool named(const Nodeset& nodeset, const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), nodeset.name) != names.end();
}

std::vector<std::string_view> knownNames() {
    std::vector<std::string_view> known;
    for (const auto& nodeset : kModel) {
        known.push_back(nodeset.name);
    }
    for (const auto& nodeset : kInstances) {
        known.push_back(nodeset.name);
    }
    return known;
}

Result<> load(UA_Server* server, const Nodeset& nodeset) {
    const auto code = nodeset.load(server);
    if (code == UA_STATUSCODE_GOOD) {
        return {};
    }
    return fail(
        Errc::internal,
        errorFrom(StatusCode(code), fmt::format("load the NodeSet {}", nodeset.name)).message);
}

}  // namespace

Result<> checkNodesets(const std::vector<std::string>& names) {
    const auto known = knownNames();
    for (const auto& name : names) {
        if (std::find(known.begin(), known.end(), name) == known.end()) {
            return fail(Errc::not_found, fmt::format("no NodeSet '{}', only {}", sanitise(name),
                                                     fmt::join(known, ", ")));
        }
    }
    return {};
}

Result<> loadNodesets(UA_Server* server, const std::vector<std::string>& names) {
    if (names.empty()) {
        return {};
    }
    for (const auto& nodeset : kModel) {
        METIER_TRY(load(server, nodeset));
    }
    for (const auto& nodeset : kInstances) {
        if (!named(nodeset, names)) {
            continue;
        }
        METIER_TRY(load(server, nodeset));
    }
    return {};
}

}  // namespace metier::opcua
