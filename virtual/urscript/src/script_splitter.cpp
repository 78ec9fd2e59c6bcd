#include "metier/urscript/script_splitter.hpp"

#include <fmt/format.h>

#include <utility>

#include "metier/urscript/program.hpp"
#include "token.hpp"

namespace metier::urscript {

Result<void> ScriptSplitter::push(std::string_view bytes, std::vector<std::string>& programs) {
    Result<void> result;
    for (const char c : bytes) {
        if (drops_line_) {
            drops_line_ = c != '\n';
            continue;
        }
        line_ += c;
        if (line_.size() + program_.size() > Program::kMaxText) {
            *this = ScriptSplitter();
            drops_line_ = c != '\n';
            result = fail(Errc::out_of_range,
                          fmt::format("script is longer than {} bytes", Program::kMaxText));
        } else if (c == '\n') {
            takeLine(programs);
        }
    }
    return result;
}

void ScriptSplitter::takeLine(std::vector<std::string>& programs) {
    const LineBlocks blocks = blocksOf(line_);
    const std::string line = std::exchange(line_, {});
    if (blocks.empty && open_blocks_ == 0) {
        return;
    }
    program_ += line;
    open_blocks_ += blocks.opened;
    if (open_blocks_ <= 0) {
        open_blocks_ = 0;
        programs.push_back(std::exchange(program_, {}));
    }
}

}  // namespace metier::urscript
