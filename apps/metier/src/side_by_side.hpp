#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace metier::app {

/// Reports the progress of a row: the finished fraction, 0 to 1, and the present action.
/// Threads: that of the row.
using TellRow = std::function<void(double fraction, std::string text)>;

/// Works on all rows at the same time, one thread each, and shows how they go on. Returns when the
/// last has ended.
/// \param longest after it nothing is shown any more: each row is to have a deadline of its own
/// \param work    of a row, by its index; returns whether it went well
void runSideBySide(const std::vector<std::string>& names,
                   std::chrono::steady_clock::duration longest,
                   const std::function<bool(std::size_t row, const TellRow& tell)>& work);

}  // namespace metier::app
