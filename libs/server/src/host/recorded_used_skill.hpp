#pragma once

#include <memory>

#include "metier/composition/used_skill.hpp"
#include "metier/server/foreign_records.hpp"

namespace metier::server {

/// A used skill whose executions are recorded while UsedSkill::lacks() names something: then its
/// server is not one of metier's. All calls go to `used`.
std::unique_ptr<composition::UsedSkill> recorded(std::unique_ptr<composition::UsedSkill> used,
                                                 std::shared_ptr<ForeignRecords> records,
                                                 ForeignPlace place);

}  // namespace metier::server
