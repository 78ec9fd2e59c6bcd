#include "nodesets/enum_definitions.hpp"

#include "common/convert.hpp"
#include "metier/opcua/standard_ids.hpp"
#include "nodesets/nodeset_file.hpp"

namespace metier::opcua {

namespace {

LocalizedText textOfElement(const pugi::xml_node& element) {
    return {element.attribute("Locale").value(), element.child_value()};
}

void fill(UA_EnumField& field, const pugi::xml_node& element) {
    const std::string name = element.attribute("Name").value();
    const auto display_name = childNamed(element, "DisplayName");
    field.value = element.attribute("Value").as_llong(-1);
    toNative(name, field.name);
    toNative(display_name.empty() ? LocalizedText{"", name} : textOfElement(display_name),
             field.displayName);
    toNative(textOfElement(childNamed(element, "Description")), field.description);
}

std::vector<pugi::xml_node> fieldsIn(const pugi::xml_node& data_type) {
    std::vector<pugi::xml_node> fields;
    for (const auto& field : childNamed(data_type, "Definition").children()) {
        if (localName(field) == "Field") {
            fields.push_back(field);
        }
    }
    return fields;
}

}  // namespace

void defineEnumerations(const std::vector<DataTypeElement>& elements, const TypeTree& tree,
                        DataTypeStore& store) {
    for (const auto& element : elements) {
        const auto fields = fieldsIn(element.element);
        if (fields.empty() || !tree.isA(element.id, ids::kEnumeration)) {
            continue;
        }
        const auto defined = store.defineEnumeration(element.id, fields.size());
        for (std::size_t i = 0; i < fields.size(); ++i) {
            fill(defined[i], fields[i]);
        }
    }
}

}  // namespace metier::opcua
