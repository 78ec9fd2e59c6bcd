#pragma once

namespace metier {

/// Visitor for std::visit made of lambdas, one for each alternative of a std::variant:
///
///     std::visit(overloaded{[](double number) { ... }, [](const auto& other) { ... }}, value);
template <typename... Functions>
struct overloaded : Functions... {
    using Functions::operator()...;
};
template <typename... Functions>
overloaded(Functions...) -> overloaded<Functions...>;

}  // namespace metier
