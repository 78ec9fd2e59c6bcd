#include "metier/opcua_skill/skill_controller.hpp"

#include "model_ids.hpp"

namespace metier::opcua_skill {
namespace {

constexpr std::uint32_t kDeviceSet = 5001;

}  // namespace

Result<SkillController> findSkillController(const opcua::AddressSpace& nodes) {
    const auto di = nodes.namespaceIndex(kDiUri);
    const auto device = nodes.namespaceIndex(kDeviceUri);
    if (!di || !device) {
        return fail(di ? device.error() : di.error());
    }
    const auto objects = nodes.browse(opcua::NodeId(*di, kDeviceSet));
    if (!objects) {
        return fail(objects.error());
    }
    for (const auto& object : *objects) {
        if (auto skills = nodes.find(object.target, {*device, "Skills"})) {
            return SkillController{object.target, std::move(*skills)};
        }
    }
    return fail(Errc::not_found, "no object below DeviceSet has skills");
}

}  // namespace metier::opcua_skill
