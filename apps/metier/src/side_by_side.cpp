#include "side_by_side.hpp"

#include <thread>
#include <utility>

#include "metier/base/queue.hpp"
#include "progress_view.hpp"

namespace metier::app {
namespace {

constexpr std::size_t kUpdates = 10'000;

struct Update {
    std::size_t row = 0;
    double fraction = 0.0;
    std::string text;
    bool last = false;
};

}  // namespace

void runSideBySide(const std::vector<std::string>& names,
                   std::chrono::steady_clock::duration longest,
                   const std::function<bool(std::size_t row, const TellRow& tell)>& work) {
    ProgressView view(names, ProgressView::detect());
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
