#pragma once

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <type_traits>
#include <utility>

#include "metier/base/error.hpp"
#include "metier/records/store.hpp"

namespace metier::records {

/// A store that is opened at its first use and kept open. It is opened anew when its file was
/// replaced or its database was away:
///
///     auto rows = store.use([&](Store& records) { return records.list(filter, page); });
///
/// Threading: any number of threads, one after the other. No server's thread: use() waits.
class KeptStore {
public:
    /// Longest wait for other threads.
    static constexpr std::chrono::seconds kPatience{10};

    /// \param url as Store::open() takes it
    explicit KeptStore(std::string url) : url_(std::move(url)) {}

    /// Returns the Result of work(Store&). After an error that may come from an old connection,
    /// `work` is called once more, with a new one.
    /// Errors: those of Store::open() and of `work`; resource_unavailable (kPatience passed).
    template <typename Work>
    /// Returns the Result of work(Store&). After an error that may come from an old connection,
    /// `work` is called once more, with a new one. Waits for other threads, kPatience at most, and
    /// for the store.
    /// Errors: those of Store::open() and of `work`; resource_unavailable (kPatience passed).
    auto use(Work work) -> std::invoke_result_t<Work, Store&> {
        if (!take()) {
            return fail(Errc::resource_unavailable, "records are being read for others");
        }
        const std::unique_ptr<KeptStore, GiveBack> taken(this);
        const bool kept = store_ != nullptr && store_->isCurrent();
        auto result = kept ? work(*store_) : useNew(work);
        return kept && !result && isOfConnection(result.error().code) ? useNew(work) : result;
    }

private:
    struct GiveBack {
        void operator()(KeptStore* store) const { store->giveBack(); }
    };
    template <typename Work>
    auto useNew(Work work) -> std::invoke_result_t<Work, Store&> {
        METIER_TRY(open());
        return work(*store_);
    }
    bool take();
    void giveBack();
    Result<void> open();
    static bool isOfConnection(Errc code);

    const std::string url_;
    std::mutex mutex_;
    std::condition_variable given_back_;
    bool taken_ = false;
    std::unique_ptr<Store> store_;  // used by the thread that has taken it
};

}  // namespace metier::records
