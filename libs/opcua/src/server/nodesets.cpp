#include "server/nodesets.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "metier/nodesets/nodesets.h"
#include "metier/opcua/status_code.hpp"
#include "metier/opcua/text.hpp"
#include "nodesets/load_order.hpp"
#include "nodesets/nodeset_loader.hpp"

namespace metier::opcua {

namespace {

struct Nodeset {
    std::string_view name;
    std::string_view uri;
    UA_StatusCode (*load)(UA_Server*);
};

/// NodeSets that all of ours need, in the order of loading.
constexpr std::array kModel{
    Nodeset{"di", "http://opcfoundation.org/UA/DI/", namespace_di_generated},
    Nodeset{"ia", "http://opcfoundation.org/UA/IA/", namespace_ia_generated},
    Nodeset{"rob", "http://opcfoundation.org/UA/Robotics/", namespace_rob_generated},
    Nodeset{"device", "https://fortiss.org/UA/Device/", namespace_device_generated},
    Nodeset{"robotics", "https://fortiss.org/UA/Robotics/", namespace_robotics_generated},
    Nodeset{"metier", "urn:metier:skills", namespace_metier_generated},
};

constexpr std::array kInstances{
    Nodeset{"iiwa", "https://fortiss.org/UA/iiwa/", namespace_iiwa_generated},
    Nodeset{"edo", "https://fortiss.org/UA/edo/", namespace_edo_generated},
    Nodeset{"universal_robots", "https://fortiss.org/UA/universal_robots/",
            namespace_universal_robots_generated},
    Nodeset{"wsg50", "https://fortiss.org/UA/wsg50/", namespace_wsg50_generated},
};

constexpr std::string_view kStandardUri = "http://opcfoundation.org/UA/";

/// The short name of a compiled NodeSet; empty if there is none of that URI.
std::string_view compiledName(std::string_view uri) {
    for (const auto& nodeset : kModel) {
        if (nodeset.uri == uri) {
            return nodeset.name;
        }
    }
    for (const auto& nodeset : kInstances) {
        if (nodeset.uri == uri) {
            return nodeset.name;
        }
    }
    return {};
}

bool isCompiledIn(const std::string& uri) {
    return uri == kStandardUri || !compiledName(uri).empty();
}

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

/// Names of the compiled NodeSets that a file needs.
std::vector<std::string> neededBy(const NodesetFile& file) {
    std::vector<std::string> names;
    for (const auto& model : file.models()) {
        for (const auto& required : model.required) {
            if (const auto name = compiledName(required.uri); !name.empty()) {
                names.emplace_back(name);
            }
        }
    }
    return names;
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

Result<NodesetFiles> readNodesetFiles(const std::vector<std::filesystem::path>& paths) {
    NodesetFiles read;
    for (const auto& path : paths) {
        METIER_ASSIGN(auto file, NodesetFile::load(path));
        auto names = neededBy(file);
        read.needed.insert(read.needed.end(), names.begin(), names.end());
        read.files.push_back(std::move(file));
    }
    return read;
}

Result<> loadNodesetFiles(UA_Server* server, const NodesetFiles& files, DataTypeStore& store,
                          spdlog::logger& log) {
    METIER_ASSIGN(const auto order, inLoadOrder(files.files, isCompiledIn));
    for (const auto& file : files.files) {
        if (std::find(order.begin(), order.end(), &file) == order.end()) {
            log.info("{} is not loaded: its model is compiled in", file.name());
        }
    }
    NodesetLoader loader(server, store);
    for (const auto* file : order) {
        METIER_TRY(loader.load(*file));
    }
    constexpr std::size_t kMostNotes = 20;
    const auto& notes = loader.notes();
    for (std::size_t i = 0; i < std::min(notes.size(), kMostNotes); ++i) {
        log.warn("{}", notes[i]);
    }
    if (notes.size() > kMostNotes) {
        log.warn("{} more parts of NodeSet files are left out", notes.size() - kMostNotes);
    }
    return {};
}

}  // namespace metier::opcua
