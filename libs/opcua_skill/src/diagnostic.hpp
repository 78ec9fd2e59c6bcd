#pragma once

#include "metier/opcua/value.hpp"
#include "metier/skill/program_observer.hpp"
#include "node_role.hpp"

namespace metier::opcua_skill {

/// The diagnostic as it travels. Start takes no arguments: what its client had written to the
/// parameters stands in for them.
opcua::ProgramDiagnostic toOpcua(const skill::Diagnostic& diagnostic);

/// One component of the diagnostic, or all of it.
opcua::Value readDiagnostic(const skill::Diagnostic& diagnostic, DiagnosticItem item);

}  // namespace metier::opcua_skill
