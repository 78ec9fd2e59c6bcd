#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"

namespace metier::urscript {

/// Cuts what a client sends to a script port into programs: each `def`/`sec` up to its `end`, and
/// each line outside of these, are a program of their own. Empty lines and comments are dropped.
///
/// One per connection. Threading: one thread.
class ScriptSplitter {
public:
    /// Takes bytes as they came and appends each program that is now complete, oldest first.
    /// Errors: out_of_range if a program grows beyond Program::kMaxText; what was collected is
    ///         dropped, and the splitter begins anew with the next line.
    Result<void> push(std::string_view bytes, std::vector<std::string>& programs);

private:
    void takeLine(std::vector<std::string>& programs);

    std::string line_;     // what came since the last line feed
    std::string program_;  // the lines of a block that is not closed yet
    int open_blocks_ = 0;
};

}  // namespace metier::urscript
