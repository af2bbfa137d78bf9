// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// NATS JetStream as the rest of server/cluster uses it: streams, messages, consumers. engine.cpp alone names its
// library.
namespace aeolis::server::cluster {

/// The address of an engine, and the credentials of its client. A URL may hold user:password@ or token@; a file of
/// credentials keeps them out of
/// the list of processes.
struct EngineAddress {
    std::string url;  ///< nats://HOST:PORT or tls://HOST:PORT, or several such with commas between them
    std::filesystem::path credentials;  ///< a .creds file of a user's JWT and seed; empty: none
    std::string nkey;                   ///< a public nkey, with the file of its seed; empty: none
    std::filesystem::path nkey_seed;
    std::filesystem::path ca;           ///< certificates that sign the engine's; empty: the system's
    std::filesystem::path certificate;  ///< of this client, with `key`; empty: none
    std::filesystem::path key;
};

/// The address without its secrets, as logs and messages may show it.
std::string shown(const EngineAddress& address);

/// How long a stream keeps its messages.
enum class Retention : std::uint8_t {
    newest,       ///< the newest of each subject
    until_taken,  ///< each until its one consumer has taken it
    all           ///< every message, unless an administrator has set limits
};

/// A message in a stream, and its place there.
struct Stored {
    std::string octets;
    std::uint64_t place = 0;
};

/// A message that a consumer was given. Unless it is taken, it is given again: after the consumer's time, or at once
/// when its holder says so.
class Given {
  public:
    Given(Given&&) noexcept;
    Given& operator=(Given&&) noexcept;
    ~Given();

    std::string_view octets() const;
    std::uint64_t times() const;  ///< how often it was given, this time included
    std::uint64_t place() const;  ///< in its stream
    std::uint64_t count() const;  ///< of what its consumer was given, from 1
    /// It is done, once the engine has confirmed that. The Error: it may be given again.
    Result<void> take();
    void keep_waiting();  ///< starts the consumer's time anew
    void give_back();     ///< somebody else may have it at once

  private:
    friend class Consumer;
    struct State;
    explicit Given(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

/// A place in a stream that the engine remembers. One thread owns it.
class Consumer {
  public:
    Consumer(Consumer&&) noexcept;
    Consumer& operator=(Consumer&&) noexcept;
    ~Consumer();

    /// At most `count` messages, after `wait` at the latest; none: there was none. The Error: the engine is away, or
    /// the consumer is gone.
    Result<std::vector<Given>> next(std::size_t count, std::chrono::milliseconds wait);

  private:
    friend class Engine;
    struct State;
    explicit Consumer(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

/// A message that no stream keeps.
struct PlainMessage {
    std::string subject, octets;
    std::string answer_to;      ///< subject of the answer; empty: none is wanted
    bool nobody_there = false;  ///< the engine says that nobody listens to what was asked
};

/// A subject that is listened to, also after the connection was lost and opened again. One thread owns it.
class Listening {
  public:
    Listening(Listening&&) noexcept;
    Listening& operator=(Listening&&) noexcept;
    ~Listening();

    /// The next message, after `wait` at the latest; none: there was none.
    Result<std::optional<PlainMessage>> next(std::chrono::milliseconds wait);

  private:
    friend class Engine;
    struct State;
    explicit Listening(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

/// A connection to an engine with JetStream.
///
/// Faults   each Error names the engine and what it refused. A lost connection is opened again without end; meanwhile
///          calls fail after `patience`
/// Threads  any; a Consumer is its owner's
class Engine {
  public:
    static constexpr std::chrono::milliseconds patience{3000};

    /// @param name  of this client, as the engine's list of connections shows it
    static Result<Engine> connect(const EngineAddress& address, const std::string& name);
    Engine(Engine&&) noexcept;
    Engine& operator=(Engine&&) noexcept;
    ~Engine();

    bool connected() const;

    /// Makes the stream of these subjects unless there is one of this name, which must then be of the same form.
    Result<void> make_stream(const std::string& stream, const std::string& subjects, Retention retention);
    /// Publishes a message, which is stored when this returns.
    Result<void> publish(const std::string& subject, std::string_view octets);
    /// Publishes several messages, which are all stored when this returns. After an Error, any of them may be stored.
    Result<void> publish(const std::string& subject, const std::vector<std::string>& messages);
    /// The subjects of a stream that have messages, among those that `filter` matches; none where there is no stream.
    Result<std::vector<std::string>> subjects(const std::string& stream, const std::string& filter);
    /// The newest message of a subject; none: it has none.
    Result<std::optional<Stored>> newest(const std::string& stream, const std::string& subject);
    /// Stored when it returns, behind the subject's newest message, which must be at `after`; 0: it has none. After an
    /// Error it may be stored. @return its place
    Result<std::uint64_t> publish_after(const std::string& subject, std::string_view octets, std::uint64_t after);
    /// What tells a stream from another one of its name; empty: there is none.
    struct StreamFacts {
        std::string made;
        std::uint64_t first = 0, last = 0;  ///< places of its messages
    };
    Result<StreamFacts> facts(const std::string& stream);
    /// Removes a subject's messages.
    Result<void> clear(const std::string& stream, const std::string& subject);

    /// Makes the consumer of a subject unless there is one of this name. It gives a message again after `again_after`.
    Result<void> make_consumer(const std::string& stream, const std::string& name, const std::string& subject,
                               std::chrono::seconds again_after);
    /// Makes the consumer of subjects, in place of one of this name, from a place of the stream on. Each message is
    /// given once, and need not be taken.
    Result<Consumer> read(const std::string& stream, const std::string& name, const std::string& subjects,
                          std::uint64_t from);
    Result<void> remove_consumer(const std::string& stream, const std::string& name);
    Result<Consumer> consumer(const std::string& stream, const std::string& name, const std::string& subject);
    /// Messages that its consumer has not taken: waiting, or given and not yet taken.
    Result<std::uint64_t> untaken(const std::string& stream, const std::string& consumer);

    /// Sends a message that no stream keeps. Nobody is waited for.
    Result<void> send(const std::string& subject, std::string_view octets, const std::string& answer_to = {});
    Result<Listening> listen(const std::string& subject);  ///< hears what is sent from its return on
    /// A subject that no other client has, for answers.
    static std::string own_subject();

  private:
    struct State;
    explicit Engine(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace aeolis::server::cluster
