#pragma once

#include <vector>

#include "nodesets/data_types.hpp"
#include "nodesets/type_tree.hpp"

namespace metier::opcua {

/// Notes the definitions that a NodeSet file has of its enumerations.
/// \param tree knows the types above those of the file
void defineEnumerations(const std::vector<DataTypeElement>& elements, const TypeTree& tree,
                        DataTypeStore& store);

}  // namespace metier::opcua
