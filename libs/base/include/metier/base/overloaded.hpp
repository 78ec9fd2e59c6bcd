#pragma once

namespace metier {

/// One function object for each kind of a std::variant, for std::visit.
template <typename... Functions>
struct overloaded : Functions... {
    using Functions::operator()...;
};
template <typename... Functions>
overloaded(Functions...) -> overloaded<Functions...>;

}  // namespace metier
