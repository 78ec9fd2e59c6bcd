#include "builtin.hpp"

#include <map>

namespace metier::urscript {
namespace {

std::map<std::string_view, const Builtin*> byName() {
    std::map<std::string_view, const Builtin*> all;
    for (const auto group :
         {mathBuiltins(), poseBuiltins(), textBuiltins(), listBuiltins(), stateBuiltins(),
          motionBuiltins(), settingBuiltins(), registerBuiltins(), inputOutputBuiltins(),
          socketBuiltins(), programBuiltins()}) {
        for (const Builtin& builtin : group) {
            all.emplace(builtin.name, &builtin);
        }
    }
    return all;
}

}  // namespace

const Builtin* findBuiltin(std::string_view name) {
    static const auto kAll = byName();
    const auto found = kAll.find(name);
    return found == kAll.end() ? nullptr : found->second;
}

}  // namespace metier::urscript
