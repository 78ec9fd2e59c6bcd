#include "progress_view.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string_view>

namespace metier::app {
namespace {

constexpr int kBarWidth = 24;

std::string bar(double fraction) {
    const int filled = static_cast<int>(std::lround(std::clamp(fraction, 0.0, 1.0) * kBarWidth));
    std::string text;
    for (int i = 0; i < kBarWidth; ++i) {
        text += i < filled ? "█" : "░";
    }
    return text;
}

}  // namespace

ProgressView::Output ProgressView::detect() {
    const char* term = std::getenv("TERM");
    const bool dumb = term == nullptr || std::string_view(term) == "dumb";
    return isatty(STDERR_FILENO) == 1 && !dumb && std::getenv("NO_COLOR") == nullptr
               ? Output::terminal
               : Output::plain;
}

ProgressView::ProgressView(std::vector<std::string> names, Output output) : output_(output) {
    for (auto& name : names) {
        rows_.push_back({std::move(name), "waiting", 0.0});
    }
}

void ProgressView::update(std::size_t row, double fraction, const std::string& text) {
    rows_[row].fraction = fraction;
    rows_[row].text = text;
    if (output_ == Output::terminal) {
        redraw();
    }
}

void ProgressView::finish(std::size_t row, const std::string& text) {
    rows_[row].fraction = 1.0;
    rows_[row].text = text;
    if (output_ == Output::terminal) {
        redraw();
    } else {
        fmt::print(stderr, "{}: {}\n", rows_[row].name, text);
    }
}

void ProgressView::redraw() {
    if (drawn_) {
        fmt::print(stderr, "\x1b[{}A", rows_.size());
    }
    drawn_ = true;
    for (const auto& row : rows_) {
        fmt::print(stderr, "\x1b[2K{:<22} {} {}\n", row.name, bar(row.fraction), row.text);
    }
}

}  // namespace metier::app
