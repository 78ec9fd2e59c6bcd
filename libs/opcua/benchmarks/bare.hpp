#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace metier::opcua::bare {

/// A server as anyone makes one with open62541 alone, its own event loop and configuration
/// included: the baseline of metier's benchmarks.
///
/// It has one Program with a method `Start` that raises two transition events, and can add many
/// idle Programs. Threading: one thread of its own serves; functions from the creating thread.
class Server {
public:
    Server();
    ~Server();
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    std::string url() const;
    /// Adds Programs with three methods and six parameters each, before start().
    void addPrograms(std::uint32_t count);
    void start();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// A client as anyone makes one with open62541 alone.
///
/// Threading: one thread.
class Client {
public:
    explicit Client(const std::string& url);
    ~Client();
    Client(const Client&) = delete;
    Client& operator=(const Client&) = delete;

    /// Calls a method without arguments that does nothing.
    void callNothing();
    /// Calls a method without arguments of another server. Ids as text, such as `ns=2;i=1`.
    void call(const std::string& object, const std::string& method);
    /// Writes a number, and waits for the answer. Id as text.
    void write(const std::string& variable, double value);
    /// Reads a number. Id as text.
    double read(const std::string& variable);
    /// Writes a parameter of the first of the added Programs, and waits for the answer.
    void writeParameter(double value);
    /// Calls the Program's Start, which raises two events.
    void callStart();
    /// Subscribes to the Program's events.
    void subscribe(std::chrono::milliseconds publishing_interval, std::function<void()> on_event);
    /// Serves the connection until something arrives or the time is over.
    void iterate(std::chrono::milliseconds timeout);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace metier::opcua::bare
