#pragma once

#include <functional>
#include <string>
#include <thread>

namespace metier::benchmarks {

/// Turns recording on and off in a server's process.
///
/// Threading: one thread on each side.
class RecordingSwitch {
public:
    /// \param file of the records
    explicit RecordingSwitch(std::string file);
    ~RecordingSwitch();
    RecordingSwitch(const RecordingSwitch&) = delete;
    RecordingSwitch& operator=(const RecordingSwitch&) = delete;

    const std::string& file() const noexcept { return file_; }
    /// Returns once it is so. Errors: exceptions.
    void turn(bool on) const;

    /// Called with the argument of turn(); it must call `done`. It runs in the server's process, on
    /// a thread that ends with the answer.
    using Switch = std::function<void(bool on, std::function<void()> done)>;
    class Serving {
    public:
        Serving() = default;
        Serving(int socket, Switch turn);
        ~Serving();
        Serving(Serving&& other) noexcept;
        Serving& operator=(Serving&& other) noexcept;

    private:
        int socket_ = -1;
        std::jthread thread_;
    };
    Serving serve(Switch turn) const { return {server_side_, std::move(turn)}; }

private:
    const std::string file_;
    int client_side_ = -1;
    int server_side_ = -1;
};

}  // namespace metier::benchmarks
