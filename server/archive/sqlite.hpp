// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

struct sqlite3;
struct sqlite3_stmt;

// SQLite's C interface with ownership, types and Result. It knows no rules of the archive.
namespace aeolis::archive::sqlite {

/// A count as SQLite's integer type.
inline std::int64_t number(std::uint64_t value) {
    return static_cast<std::int64_t>(value);
}

/// A prepared statement. Bound text and octets are not copied: they must live until the next reset().
class Statement {
  public:
    Statement() = default;

    /// Parameters are numbered from 1.
    Statement& bind(int parameter, std::int64_t value);
    Statement& bind(int parameter, double value);
    Statement& bind(int parameter, std::string_view text);
    Statement& bind_octets(int parameter, std::span<const std::uint8_t> octets);
    Statement& bind_null(int parameter);

    /// Steps. True: a row is ready. False: done, and reset. An Error also resets.
    Result<bool> step();
    /// Runs a statement that returns no rows.
    Result<void> run();
    void reset();

    /// Columns of the current row, from 0. Text and octets are valid until the next step().
    std::int64_t integer(int column) const;
    double real(int column) const;
    std::string_view text(int column) const;
    std::span<const std::uint8_t> octets(int column) const;
    bool is_null(int column) const;
    int columns() const;
    /// Appends a column's type and value, exactly: equal octets mean equal columns. For hashes.
    void append_exact(int column, std::vector<std::uint8_t>& octets) const;

  private:
    friend class Database;
    struct Finalize {
        void operator()(sqlite3_stmt* statement) const;
    };
    std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

enum class Mode { read_only, read_write_create };

/// One connection, one owner.
class Database {
  public:
    /// Opens a file. Only the owner may read a new file (mode 0600), whatever the umask, and SQLite gives its log and
    /// its shared memory the same mode. An existing file keeps its mode.
    static Result<Database> open(const std::string& file, Mode mode);

    Result<void> execute(const char* sql);
    Result<Statement> prepare(const char* sql);
    /// The first column of the first row; 0 when there is no row.
    Result<std::int64_t> integer_of(const char* sql);

    /// Attaches a file, read-only, as schema `name`.
    Result<void> attach_read_only(const std::filesystem::path& file, const char* name);
    /// Copies this database, as it is now, into an empty one. Writers of this one proceed meanwhile.
    Result<void> copy_to(Database& empty) const;

    /// Sets the stop condition: a statement ends with an Error soon after `stop` returns true. Null: never.
    void stop_when(std::function<bool()> stop);
    /// Whether a statement has been stopped since.
    bool stopped() const;
    /// Whether the file was removed or replaced under its name; this connection still uses the file that it opened.
    bool moved() const;

    /// False while a transaction is open.
    bool autocommit() const;
    Error error(std::string_view doing) const;
    const std::string& file() const { return file_; }
    sqlite3* handle() const { return database_.get(); }

  private:
    struct Close {
        void operator()(sqlite3* database) const;
    };
    struct Stop {
        std::function<bool()> wanted;
        bool happened = false;
    };
    std::string file_;
    std::unique_ptr<Stop> stop_;  ///< SQLite holds its address
    std::unique_ptr<sqlite3, Close> database_;
};

/// BEGIN; rolled back at the end of the scope unless committed.
class Transaction {
  public:
    static Result<Transaction> begin_write(Database& database);
    static Result<Transaction> begin_read(Database& database);

    Transaction(Transaction&& other) noexcept : database_(std::exchange(other.database_, nullptr)) {}
    Transaction& operator=(Transaction&&) = delete;
    ~Transaction();

    /// Durable when ok. After an Error nothing of the transaction is stored.
    Result<void> commit();

  private:
    explicit Transaction(Database& database) : database_(&database) {}
    Database* database_;
};

}  // namespace aeolis::archive::sqlite
