#pragma once

#include <span>
#include <string_view>

#include "metier/opcua/value.hpp"
#include "metier/skill/program_observer.hpp"

namespace metier::opcua_skill {

/// The diagnostic as it travels. Start takes no arguments: what its client had written to the
/// parameters stands in for them.
opcua::ProgramDiagnostic toOpcua(const skill::Diagnostic& diagnostic);

/// The diagnostic as a whole, or one of its components.
struct DiagnosticItem {
    std::string_view path;  ///< below ProgramDiagnostic, "/LastMethodCall"; empty: the whole
    opcua::Value (*read)(const opcua::ProgramDiagnostic& diagnostic);
};
std::span<const DiagnosticItem> diagnosticItems();

}  // namespace metier::opcua_skill
