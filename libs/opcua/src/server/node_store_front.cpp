#include "server/node_store_front.hpp"

#include <cstddef>

#include "common/convert.hpp"
#include "common/guard.hpp"

namespace metier::opcua {

namespace {

static_assert(offsetof(UA_ReadValueId, nodeId) == 0, "a request begins with its NodeId");

/// Request that a NodeId is the beginning of.
UA_ReadValueId* requestOf(const UA_NodeId* id) noexcept {
    // NOLINTNEXTLINE(*-const-cast): no request of the stack is const itself
    return const_cast<UA_ReadValueId*>(reinterpret_cast<const UA_ReadValueId*>(id));
}

/// Whether the stack may be reading a DataTypeDefinition. Its table of masks (1.4) is off by one:
/// it asks with the mask of RolePermissions. No other part of it uses either mask.
bool readsDefinition(UA_UInt32 attributes) noexcept {
    return attributes == UA_NODEATTRIBUTESMASK_DATATYPEDEFINITION ||
           attributes == UA_NODEATTRIBUTESMASK_ROLEPERMISSIONS;
}

/// Whether the Call service looks up the Method. No other part of the stack (1.4) has this mask.
bool looksUpMethod(UA_UInt32 attributes) noexcept {
    return attributes == (UA_NODEATTRIBUTESMASK_NODECLASS | UA_NODEATTRIBUTESMASK_EXECUTABLE);
}

/// Passes a call on to the node store behind.
template <auto kFunction>
struct Pass;
template <typename Answer, typename... Arguments,
          Answer (*UA_Nodestore::*kFunction)(void*, Arguments...)>
struct Pass<kFunction> {
    static Answer on(const UA_Nodestore& behind, Arguments... arguments) noexcept {
        return (behind.*kFunction)(behind.context, arguments...);
    }
};

}  // namespace

/// Callbacks of the node store in front.
struct NodeStoreFront::Front {
    static NodeStoreFront& of(void* context) noexcept {
        return *static_cast<NodeStoreFront*>(context);
    }

    template <auto kFunction>
    static void pass(UA_Nodestore& front) {
        front.*kFunction = [](void* context, auto... arguments) {
            return Pass<kFunction>::on(of(context).behind_, arguments...);
        };
    }

    static const UA_Node* getNode(void* context, const UA_NodeId* id, UA_UInt32 attributes,
                                  UA_ReferenceTypeSet references,
                                  UA_BrowseDirection directions) noexcept {
        auto& self = of(context);
        const UA_Node* stand_in = nullptr;
        if (readsDefinition(attributes)) {
            guarded([&] { stand_in = self.lend(*id); });
        }
        if (stand_in != nullptr) {
            return stand_in;
        }
        const auto* const node =
            Pass<&UA_Nodestore::getNode>::on(self.behind_, id, attributes, references, directions);
        if (node != nullptr && looksUpMethod(attributes) &&
            node->head.nodeClass != UA_NODECLASS_METHOD) {
            Pass<&UA_Nodestore::releaseNode>::on(self.behind_, node);
            return nullptr;
        }
        return node;
    }

    static void releaseNode(void* context, const UA_Node* node) noexcept {
        auto& self = of(context);
        if (node == &self.stand_in_) {
            self.takeBack();
        } else {
            Pass<&UA_Nodestore::releaseNode>::on(self.behind_, node);
        }
    }
};

NodeStoreFront::NodeStoreFront(const DataTypeStore& types) : types_(types) {
    auto& variable = stand_in_.variableNode;
    variable = UA_VariableNode{};
    variable.head.nodeClass = UA_NODECLASS_VARIABLE;
    variable.accessLevel = UA_ACCESSLEVELMASK_READ;
    variable.valueSource = UA_VALUESOURCE_DATA;
    variable.value.data.value.hasValue = true;
}

void NodeStoreFront::install(UA_Nodestore& store) {
    behind_ = store;
    store.context = this;
    Front::pass<&UA_Nodestore::clear>(store);
    Front::pass<&UA_Nodestore::newNode>(store);
    Front::pass<&UA_Nodestore::deleteNode>(store);
    store.getNode = Front::getNode;
    Front::pass<&UA_Nodestore::getNodeFromPtr>(store);
    store.releaseNode = Front::releaseNode;
    Front::pass<&UA_Nodestore::getNodeCopy>(store);
    Front::pass<&UA_Nodestore::insertNode>(store);
    Front::pass<&UA_Nodestore::replaceNode>(store);
    Front::pass<&UA_Nodestore::removeNode>(store);
    Front::pass<&UA_Nodestore::getReferenceTypeId>(store);
    Front::pass<&UA_Nodestore::iterate>(store);
}

/// \return null if there is no definition
const UA_Node* NodeStoreFront::lend(const UA_NodeId& data_type) {
    auto* const request = requestOf(&data_type);
    const auto* definition = types_.enumeration(fromNative(data_type));
    if (definition == nullptr || asked_ != nullptr ||
        request->attributeId != UA_ATTRIBUTEID_DATATYPEDEFINITION ||
        request->indexRange.length > 0) {
        return nullptr;
    }
    asked_ = request;
    asked_->attributeId = UA_ATTRIBUTEID_VALUE;
    stand_in_.head.nodeId = data_type;
    auto& value = stand_in_.variableNode.value.data.value.value;
    value.type = &UA_TYPES[UA_TYPES_ENUMDEFINITION];
    value.storageType = UA_VARIANT_DATA_NODELETE;
    value.data = const_cast<UA_EnumDefinition*>(definition);  // NOLINT(*-const-cast): only copied
    return &stand_in_;
}

void NodeStoreFront::takeBack() noexcept {
    asked_->attributeId = UA_ATTRIBUTEID_DATATYPEDEFINITION;
    asked_ = nullptr;
}

}  // namespace metier::opcua
