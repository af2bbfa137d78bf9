// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/check.hpp"

#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace aeolis {

/// An expected failure, in words for the person who must act on it.
/// The message names the thing and says what is wrong with it.
struct Error {
    std::string message;
    bool internal = false;  ///< the request is not at fault: a disk or a library failed, or too much is queued already
};

/// A value or an Error. Not used in flight's cycle, where a failure is a message or an event.
template <typename T>
class [[nodiscard]] Result {
  public:
    Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
    Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

    bool ok() const { return state_.index() == 0; }
    explicit operator bool() const { return ok(); }

    T& value() & {
        AEOLIS_CHECK(ok());
        return std::get<0>(state_);
    }
    const T& value() const& {
        AEOLIS_CHECK(ok());
        return std::get<0>(state_);
    }
    T&& value() && {
        AEOLIS_CHECK(ok());
        return std::get<0>(std::move(state_));
    }
    const Error& error() const {
        AEOLIS_CHECK(!ok());
        return std::get<1>(state_);
    }
    T* operator->() { return &value(); }
    const T* operator->() const { return &value(); }
    T& operator*() & { return value(); }
    const T& operator*() const& { return value(); }

  private:
    std::variant<T, Error> state_;
};

/// Success, or an Error.
template <>
class [[nodiscard]] Result<void> {
  public:
    Result() = default;
    Result(Error error) : error_(std::move(error)) {}

    bool ok() const { return !error_.has_value(); }
    explicit operator bool() const { return ok(); }
    const Error& error() const {
        AEOLIS_CHECK(!ok());
        return *error_;
    }

  private:
    std::optional<Error> error_;
};

}  // namespace aeolis
