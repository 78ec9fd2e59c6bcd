#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "metier/urscript/program.hpp"
#include "metier/urscript/script_splitter.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);  // NOLINT: bytes
    std::vector<std::string> programs;
    (void)metier::urscript::ScriptSplitter().push(text, programs);
    (void)metier::urscript::Program::parse(text);
    return 0;
}
