#include "metier/opcua_skill/gripper_node.hpp"

#include <utility>

#include "metier/opcua/status_code.hpp"
#include "model_ids.hpp"

namespace metier::opcua_skill {

using opcua::DataValue;
using opcua::Value;

Result<void> publishPartHeld(opcua::AddressSpace& nodes, const opcua::NodeId& parent,
                             std::function<std::optional<bool>()> held) {
    const auto metier = nodes.namespaceIndex(kMetierUri);
    if (!metier) {
        return fail(metier.error());
    }
    opcua::VariableSpec spec;
    spec.node.parent = parent;
    spec.node.browse_name = {*metier, "PartHeld"};
    spec.node.description = {"en", "True while the gripper holds a part."};
    spec.data_type = opcua::ids::kBoolean;
    const auto variable = nodes.addVariable(spec);
    if (!variable) {
        return fail(variable.error());
    }
    const auto read = [held = std::move(held)](const opcua::Session& /*reader*/) {
        const auto now = held();
        return now ? DataValue{Value::of(*now), {}, {}, {}}
                   : DataValue{{}, opcua::status::kBadNoCommunication, {}, {}};
    };
    return nodes.setDataSource(*variable, {read, nullptr});
}

}  // namespace metier::opcua_skill
