#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"

namespace metier::urscript {

/// Cuts the bytes that a client sends to a script port into programs: each `def` or `sec` up to its
/// `end` is a program, and each line outside of these. Empty lines and comments are dropped.
///
/// One per connection. Threading: one thread.
class ScriptSplitter {
public:
    /// Takes received bytes and appends each program that is complete now, oldest first.
    /// Bytes may be cut anywhere; an incomplete program waits for the next call.
    /// Errors: out_of_range if a program grows beyond Program::kMaxText; what was collected is
    ///         dropped, and the splitter begins anew with the next line.
    Result<void> push(std::string_view bytes, std::vector<std::string>& programs);

private:
    void takeLine(std::vector<std::string>& programs);

    std::string line_;     // bytes since the last line feed
    std::string program_;  // lines of the block that is not closed yet
    int open_blocks_ = 0;
    bool drops_line_ = false;  // until its end: the text was too long
};

}  // namespace metier::urscript
