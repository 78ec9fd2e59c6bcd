#include <fmt/format.h>

#include "commands.hpp"
#include "printable.hpp"

namespace metier::app {

Exit report(const Error& error) {
    fmt::print(stderr, "metier: {}\n", printable(error.message));
    return error.code == Errc::invalid_argument ? Exit::usage : Exit::failed;
}

Exit reportUsage(const Error& error) {
    report(error);
    return Exit::usage;
}

}  // namespace metier::app
