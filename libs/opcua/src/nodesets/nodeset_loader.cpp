#include "nodesets/nodeset_loader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <unordered_set>
#include <utility>

#include "common/convert.hpp"
#include "metier/opcua/standard_ids.hpp"
#include "metier/opcua/text.hpp"
#include "nodesets/enum_definitions.hpp"
#include "nodesets/node_adder.hpp"
#include "nodesets/node_elements.hpp"

namespace metier::opcua {

namespace {

/// Classes of nodes in the order in which they are added: each may need those before it.
constexpr std::array kClasses{UA_NODECLASS_REFERENCETYPE, UA_NODECLASS_DATATYPE,
                              UA_NODECLASS_OBJECTTYPE,    UA_NODECLASS_VARIABLETYPE,
                              UA_NODECLASS_OBJECT,        UA_NODECLASS_VARIABLE,
                              UA_NODECLASS_METHOD,        UA_NODECLASS_VIEW};

/// Adds the nodes and references of one file.
class FileLoading {
public:
    FileLoading(const NodeElements& all, const NodeAdder& adder, NodesetProblems& problems)
        : all_(all), adder_(adder), problems_(problems), marks_(all.nodes.size(), Mark::waiting) {}

    void addNodes() {
        for (const auto node_class : kClasses) {
            for (std::size_t i = 0; i < all_.nodes.size(); ++i) {
                if (all_.nodes[i].node_class == node_class) {
                    addWithParents(i);
                }
            }
        }
    }

private:
    enum class Mark { waiting, open, added, failed };

    /// Adds the parents of a node that are in the file, the topmost first, and then the node.
    void addWithParents(std::size_t node) {
        std::vector<std::size_t> chain;
        for (auto each = node; marks_[each] == Mark::waiting;) {
            marks_[each] = Mark::open;
            chain.push_back(each);
            const auto parent = all_.index.find(all_.nodes[each].parent);
            if (parent == all_.index.end()) {
                break;
            }
            each = parent->second;
            if (marks_[each] == Mark::open) {
                problems_.add(all_.nodes[each].element, "a node is above itself");
                marks_[each] = Mark::failed;
            }
        }
        std::for_each(chain.rbegin(), chain.rend(), [this](std::size_t each) { add(each); });
    }

    /// Nothing more is said of a node below one that could not be added.
    void add(std::size_t node) {
        const auto& element = all_.nodes[node];
        const auto parent = all_.index.find(element.parent);
        if (parent != all_.index.end() && marks_[parent->second] != Mark::added) {
            marks_[node] = Mark::failed;
            return;
        }
        const auto added = adder_.add(element);
        marks_[node] = added ? Mark::added : Mark::failed;
        if (!added) {
            problems_.add(added.error().element, added.error().why);
        }
    }

    const NodeElements& all_;
    const NodeAdder& adder_;
    NodesetProblems& problems_;
    std::vector<Mark> marks_;
};

std::vector<std::uint16_t> registerNamespaces(UA_Server* server, const NodesetFile& file) {
    std::vector<std::uint16_t> indices;
    for (const auto& uri : file.namespaces()) {
        indices.push_back(UA_Server_addNamespace(server, uri.c_str()));
    }
    return indices;
}

/// Adds the references of the nodes to each other and to others.
void addReferences(UA_Server* server, const NodesetFile& file, const NodeElements& all,
                   std::vector<std::string>& notes) {
    for (const auto& node : all.nodes) {
        for (const auto& reference : node.references) {
            const auto code = UA_Server_addReference(
                server, viewOf(node.id), viewOf(reference.type),
                UA_EXPANDEDNODEID_NODEID(viewOf(reference.target)), reference.forward);
            if (code != UA_STATUSCODE_GOOD &&
                code != UA_STATUSCODE_BADDUPLICATEREFERENCENOTALLOWED) {
                notes.push_back(file.problem(
                    reference.element,
                    fmt::format("the reference {} to {} is left out: {}", reference.type.toString(),
                                reference.target.toString(), StatusCode(code).name())));
            }
        }
    }
}

}  // namespace

Result<> NodesetLoader::load(const NodesetFile& file) {
    const NodesetIds ids(file, registerNamespaces(server_, file));
    NodesetProblems problems(file);
    TypeTree tree(server_);
    const auto all = readNodes(file, ids, tree, problems);
    if (!problems.empty()) {
        return fail(problems.error());
    }
    DataTypeBuilder types(server_, tree, store_);
    for (const auto& refused : types.build(all.data_types, ids)) {
        notes_.push_back(fmt::format("{}: values are not taken apart: {}", file.name(), refused));
    }
    defineEnumerations(all.data_types, tree, store_);
    const XmlValues values(ids, types, [&](const NodeId& id) {
        const auto known = all.encoded_types.find(id);
        return known != all.encoded_types.end() ? known->second
                                                : tree.source(id, ids::kHasEncoding).value_or(id);
    });
    const NodeAdder adder({server_, ids, tree, values});
    FileLoading(all, adder, problems).addNodes();
    if (!problems.empty()) {
        return fail(problems.error());
    }
    addReferences(server_, file, all, notes_);
    return {};
}

}  // namespace metier::opcua
