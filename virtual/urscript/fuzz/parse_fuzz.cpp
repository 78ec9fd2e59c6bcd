#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "metier/urscript/program.hpp"
#include "metier/urscript/script_splitter.hpp"
#include "reads.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);  // NOLINT: bytes
    std::vector<std::string> programs;
    metier::urscript::ScriptSplitter splitter;
    metier::fuzz::inReads(std::as_bytes(std::span(data, size)), [&](auto read) {
        (void)splitter.push({reinterpret_cast<const char*>(read.data()), read.size()}, programs);
    });
    for (const auto& program : programs) {
        (void)metier::urscript::Program::parse(program);
    }
    (void)metier::urscript::Program::parse(text);
    return 0;
}
