// NodeSet files: every text is read or refused, and what was read as a value can be encoded.
#include <open62541/server.h>
#include <open62541/server_config_default.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "common/convert.hpp"
#include "nodesets/data_types.hpp"
#include "nodesets/load_order.hpp"
#include "nodesets/node_elements.hpp"
#include "nodesets/nodeset_file.hpp"
#include "nodesets/nodeset_ids.hpp"
#include "nodesets/xml_values.hpp"

namespace {

using namespace metier::opcua;

void ignoreLog(void* /*context*/, UA_LogLevel /*level*/, UA_LogCategory /*category*/,
               const char* /*text*/, va_list /*arguments*/) {}

/// A server with namespace 0, for all inputs.
UA_Server* server() {
    static UA_Logger silent{ignoreLog, nullptr, nullptr};
    static UA_Server* const made = [] {
        UA_ServerConfig config{};
        config.logging = &silent;
        UA_ServerConfig_setDefault(&config);
        return UA_Server_newWithConfig(&config);
    }();
    return made;
}

void tryValue(const XmlValues& values, const pugi::xml_node& element) {
    Owned<UA_Variant> value(UA_TYPES[UA_TYPES_VARIANT]);
    if (const auto read = values.variant(childNamed(element, "Value"), {}, *value); !read) {
        if (read.error().why.empty()) {
            std::abort();
        }
        return;
    }
    Owned<UA_ByteString> bytes(UA_TYPES[UA_TYPES_BYTESTRING]);
    static_cast<void>(UA_encodeBinary(value.get(), &UA_TYPES[UA_TYPES_VARIANT], bytes.get()));
    Owned<UA_Variant> copy(UA_TYPES[UA_TYPES_VARIANT]);
    if (UA_Variant_copy(value.get(), copy.get()) != UA_STATUSCODE_GOOD) {
        std::abort();
    }
}

void use(const NodesetFile& file) {
    const NodesetIds ids(file, std::vector<std::uint16_t>(file.namespaces().size(), 1));
    NodesetProblems problems(file);
    TypeTree tree(server());
    const auto all = readNodes(file, ids, tree, problems);
    DataTypeStore store;
    auto* config = UA_Server_getConfig(server());
    const auto* const before = config->customDataTypes;
    DataTypeBuilder types(server(), tree, store);
    static_cast<void>(types.build(all.data_types, ids));
    const XmlValues values(ids, types, [&](const NodeId& id) {
        const auto known = all.encoded_types.find(id);
        return known == all.encoded_types.end() ? id : known->second;
    });
    for (const auto& node : all.nodes) {
        tryValue(values, node.element);
    }
    config->customDataTypes = before;  // those of this input end with it
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    if (const auto file = NodesetFile::parse(text, "input.xml")) {
        use(*file);
        std::vector<NodesetFile> files;
        files.push_back(NodesetFile::parse(text, "again.xml").value());
        static_cast<void>(inLoadOrder(files, [](const std::string&) { return false; }));
    }
    return 0;
}
