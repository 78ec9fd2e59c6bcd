#pragma once

#include <string>

#include "metier/base/error.hpp"

namespace metier::skill {

/// File of one line per name, which one server has to itself.
///
/// Threading: one thread at a time; every call may wait for the disk, for however long it hangs.
class NameFile {
public:
    virtual ~NameFile() = default;
    /// Errors: resource_unavailable; nothing of the line is in the file then.
    virtual Result<void> append(const std::string& line) = 0;
    /// Keeps the lines so far as the older ones, in place of those that were, and begins an empty
    /// file.
    /// Errors: resource_unavailable.
    virtual Result<void> beginAnew() = 0;
};

}  // namespace metier::skill
