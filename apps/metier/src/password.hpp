#pragma once

#include <string>

#include "metier/base/error.hpp"

namespace metier::app {

/// Reads the password from the environment variable METIER_PASSWORD, else from the terminal,
/// without showing it.
/// Errors: access_denied, if there is neither.
Result<std::string> readPassword(const std::string& user);

}  // namespace metier::app
