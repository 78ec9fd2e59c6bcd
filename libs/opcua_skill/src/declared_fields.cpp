#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "skill_layout.hpp"

namespace metier::opcua_skill {

namespace {

using opcua::AddressSpace;
using opcua::NodeId;
using opcua::Reference;

const NodeId kAnalogUnitRangeType{0, 17570U};

/// The child of that name, whatever namespace it is of.
Result<Reference> childOf(const AddressSpace& nodes, const NodeId& parent, std::string_view name) {
    METIER_ASSIGN(const auto children, nodes.browse(parent));
    const auto found = std::find_if(children.begin(), children.end(), [&](const Reference& child) {
        return child.browse_name.name == name;
    });
    return found == children.end()
               ? Result<Reference>(fail(Errc::not_found, "there is no " + std::string(name)))
               : Result<Reference>(*found);
}

/// Folder for fields of one kind, and their placeholder in the type.
struct Folder {
    std::string_view name;
    std::string_view placeholder;
    const skill::Fields& fields;
};

class Adder {
public:
    Adder(const AddressSpace& nodes, const NodeId& type, SkillLayout& layout)
        : nodes_(nodes), type_(type), layout_(layout) {}

    Result<void> addAll(const Folder& folder) {
        if (folder.fields.empty()) {
            return {};
        }
        const auto parent = indexOf(std::string(folder.name));
        METIER_ASSIGN(const auto declared, childOf(nodes_, type_, folder.name));
        METIER_ASSIGN(const auto placeholder, childOf(nodes_, declared.target, folder.placeholder));
        for (const auto& field : folder.fields) {
            METIER_TRY(add(folder, parent, placeholder, field));
        }
        return {};
    }

private:
    std::size_t indexOf(const std::string& path) const {
        const auto found = std::find_if(layout_.begin(), layout_.end(),
                                        [&](const LayoutNode& node) { return node.path == path; });
        return static_cast<std::size_t>(found - layout_.begin());
    }

    Result<void> add(const Folder& folder, std::size_t parent, const Reference& placeholder,
                     const skill::Field& field) {
        const auto path = std::string(folder.name) + "/" + field.name;
        if (indexOf(path) != layout_.size()) {
            return {};
        }
        const bool measured = field.unit.code != skill::kOne.code && field.range.has_value();
        auto reference = placeholder;
        reference.browse_name.name = field.name;
        reference.type_definition =
            measured ? kAnalogUnitRangeType : opcua::ids::kBaseDataVariableType;
        layout_.push_back({path, parent, std::move(reference), LayoutNode::Rule::mandatory, true});
        return measured ? addMeasure(path) : Result<void>{};
    }

    /// Unit and range, as AnalogUnitRangeType declares them.
    Result<void> addMeasure(const std::string& path) {
        const auto parent = layout_.size() - 1;
        for (const auto* name : {"EngineeringUnits", "EURange"}) {
            METIER_ASSIGN(const auto declared, inTypes(name));
            layout_.push_back({path + "/" + name, parent, declared});
        }
        return {};
    }

    Result<Reference> inTypes(std::string_view name) const {
        constexpr std::array<std::uint32_t, 2> kTypes{17570, 2368};  // AnalogUnitRange, AnalogItem
        for (const auto type : kTypes) {
            if (auto found = childOf(nodes_, NodeId(0, type), name)) {
                return found;
            }
        }
        return childOf(nodes_, opcua::ids::kBaseAnalogType, name);
    }

    const AddressSpace& nodes_;
    const NodeId& type_;
    SkillLayout& layout_;
};

}  // namespace

Result<void> addDeclaredFields(const AddressSpace& nodes, const NodeId& type,
                               const skill::SkillDescription& description, SkillLayout& layout) {
    Adder adder(nodes, type, layout);
    for (const auto& folder : {Folder{"ParameterSet", "<Parameter>", description.parameters},
                               Folder{"FinalResultData", "<Result>", description.results}}) {
        METIER_TRY(adder.addAll(folder));
    }
    return {};
}

}  // namespace metier::opcua_skill
