#include <fmt/format.h>

#include <fstream>

#include "commands.hpp"
#include "printable.hpp"

namespace metier::app {

Exit report(const Error& error) {
    fmt::print(stderr, "metier: {}\n", printable(error.message));
    return error.code == Errc::invalid_argument ? Exit::usage : Exit::failed;
}

Exit exitOf(const Result<Exit>& ended) {
    return ended ? *ended : report(ended.error());
}

Result<void> writeFile(const std::string& file, const std::string& text) {
    std::ofstream out(file);
    out << text;
    out.close();
    return out ? Result<void>()
               : fail(Errc::invalid_argument, fmt::format("{}: cannot be written", file));
}

}  // namespace metier::app
