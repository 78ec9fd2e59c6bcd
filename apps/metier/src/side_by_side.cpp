#include "side_by_side.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <thread>
#include <utility>

#include "metier/base/queue.hpp"

namespace metier::app {
namespace {

constexpr std::size_t kUpdates = 10'000;

struct Update {
    std::size_t row = 0;
    double fraction = 0.0;
    std::string text;
    bool last = false;
};

constexpr int kBarWidth = 24;

std::string bar(double fraction) {
    const int filled = static_cast<int>(std::lround(std::clamp(fraction, 0.0, 1.0) * kBarWidth));
    std::string text;
    for (int i = 0; i < kBarWidth; ++i) {
        text += i < filled ? "█" : "░";
    }
    return text;
}

/// Whether standard error is a terminal, and the user did not set NO_COLOR or TERM=dumb.
bool drawsInPlace() {
    const char* term = std::getenv("TERM");
    const bool dumb = term == nullptr || std::string_view(term) == "dumb";
    return isatty(STDERR_FILENO) == 1 && !dumb && std::getenv("NO_COLOR") == nullptr;
}

/// Lines on standard error, since standard output belongs to results, that show how several things
/// go on. On a terminal each line is redrawn in place; elsewhere a line is printed whenever it is
/// final.
///
/// Threading: one thread.
class ProgressView {
public:
    explicit ProgressView(const std::vector<std::string>& names) {
        for (const auto& name : names) {
            rows_.push_back({name, "waiting", 0.0});
        }
    }

    /// \param fraction done, 0 to 1
    void update(std::size_t row, double fraction, const std::string& text) {
        rows_[row].fraction = fraction;
        rows_[row].text = text;
        if (in_place_) {
            redraw();
        }
    }
    /// Marks a row as ended, with its last word.
    void finish(std::size_t row, const std::string& text) {
        update(row, 1.0, text);
        if (!in_place_) {
            fmt::print(stderr, "{}: {}\n", rows_[row].name, text);
        }
    }

private:
    struct Row {
        std::string name;
        std::string text;
        double fraction = 0;
    };
    void redraw() {
        if (drawn_) {
            fmt::print(stderr, "\x1b[{}A", rows_.size());
        }
        drawn_ = true;
        for (const auto& row : rows_) {
            fmt::print(stderr, "\x1b[2K{:<22} {} {}\n", row.name, bar(row.fraction), row.text);
        }
    }

    std::vector<Row> rows_;
    const bool in_place_ = drawsInPlace();
    bool drawn_ = false;
};

}  // namespace

void runSideBySide(const std::vector<std::string>& names,
                   std::chrono::steady_clock::duration longest,
                   const std::function<bool(std::size_t row, const TellRow& tell)>& work) {
    ProgressView view(names);
    Queue<Update> updates(kUpdates);
    std::vector<std::jthread> threads;
    for (std::size_t row = 0; row < names.size(); ++row) {
        threads.emplace_back([&, row] {
            const bool well = work(row, [&](double fraction, std::string text) {
                updates.tryPush({row, fraction, std::move(text), false});
            });
            updates.tryPush({row, 1.0, well ? "done" : "failed", true});
        });
    }
    const auto deadline = std::chrono::steady_clock::now() + longest;
    for (std::size_t running = names.size(); running > 0;) {
        const auto update = updates.popUntil(deadline);
        if (!update) {
            break;
        }
        if (update->last) {
            view.finish(update->row, update->text);
            --running;
        } else {
            view.update(update->row, update->fraction, update->text);
        }
    }
}

}  // namespace metier::app
