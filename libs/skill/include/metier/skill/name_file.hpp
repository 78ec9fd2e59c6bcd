#pragma once

#include <string>

#include "metier/base/error.hpp"

namespace metier::skill {

/// A file with one line per name, used by one server only.
///
/// Threading: one thread at a time. Every call waits for the disk, without a limit if it hangs.
class NameFile {
public:
    virtual ~NameFile() = default;
    /// Appends one line.
    /// \param line with its line end
    /// Errors: resource_unavailable; then nothing of the line is in the file.
    virtual Result<void> append(const std::string& line) = 0;
    /// Moves all lines to the older file, whose former lines are dropped, and begins an empty file.
    /// Errors: resource_unavailable. May be called again then.
    virtual Result<void> beginAnew() = 0;
};

}  // namespace metier::skill
