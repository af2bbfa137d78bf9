// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/spreadsheet/csv.hpp"

#include <algorithm>
#include <utility>

namespace aeolis::dictionary {
namespace {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

/// Steps through the characters and tracks line and column. Reads CRLF as LF.
class Cursor {
  public:
    explicit Cursor(std::string_view text) : text_(text) {}

    bool at_end() const { return position_ >= text_.size(); }
    char peek() const { return is_crlf() ? '\n' : text_[position_]; }
    char next() {
        const char c = peek();
        position_ += is_crlf() ? 2 : 1;
        if (c == '\n') {
            ++line_;
            column_ = 1;
        } else {
            ++column_;
        }
        return c;
    }
    bool take(char c) {
        if (at_end() || peek() != c) return false;
        next();
        return true;
    }
    unsigned line() const { return line_; }
    unsigned column() const { return column_; }

  private:
    bool is_crlf() const {
        return text_[position_] == '\r' && position_ + 1 < text_.size() && text_[position_ + 1] == '\n';
    }

    std::string_view text_;
    std::size_t position_ = 0;
    unsigned line_ = 1;
    unsigned column_ = 1;
};

std::string at_column(unsigned column) {
    return "column " + std::to_string(column) + ": ";
}

class Reader {
  public:
    Reader(std::string_view text, Findings& findings) : cursor_(text), findings_(findings) {}

    std::optional<Sheet> read() {
        Sheet sheet;
        while (!cursor_.at_end() && sound_) {
            auto line = row();
            if (!sound_) break;
            if (std::ranges::all_of(line.cells, &std::string::empty)) continue;
            if (sheet.header.line == 0)
                sheet.header = std::move(line);
            else if (line.cells.size() == sheet.header.cells.size())
                sheet.rows.push_back(std::move(line));
            else
                fault(line.line, "the row has " + std::to_string(line.cells.size()) + " cells, the header " +
                                     std::to_string(sheet.header.cells.size()));
        }
        if (sound_ && sheet.header.line == 0) fault(1, "the file is empty");
        if (!sound_) return std::nullopt;
        return sheet;
    }

  private:
    void fault(unsigned line, std::string message) {
        findings_.add(line, std::move(message));
        sound_ = false;
    }

    Sheet::Row row() {
        Sheet::Row row{cursor_.line(), {}};
        do {
            row.cells.push_back(cursor_.take('"') ? quoted_cell() : plain_cell());
        } while (sound_ && cursor_.take(','));
        if (sound_ && !cursor_.at_end() && !cursor_.take('\n'))
            fault(cursor_.line(),
                  at_column(cursor_.column()) + "a comma or the end of the line should follow the quote");
        return row;
    }

    std::string quoted_cell() {
        const unsigned line = cursor_.line();
        const unsigned column = cursor_.column() - 1;
        std::string cell;
        while (!cursor_.at_end()) {
            const char c = cursor_.next();
            if (c != '"') {
                cell += c;
            } else if (cursor_.take('"')) {
                cell += '"';
            } else {
                return cell;
            }
        }
        fault(line, at_column(column) + "the quote that opens here is never closed");
        return cell;
    }

    std::string plain_cell() {
        std::string cell;
        while (!cursor_.at_end() && cursor_.peek() != ',' && cursor_.peek() != '\n') {
            if (cursor_.peek() == '"') {
                fault(cursor_.line(),
                      at_column(cursor_.column()) + "a quote within a cell that does not begin with one");
                return cell;
            }
            cell += cursor_.next();
        }
        return cell;
    }

    Cursor cursor_;
    Findings& findings_;
    bool sound_ = true;
};

}  // namespace

std::optional<Sheet> read_csv(std::string_view text, Findings& findings) {
    if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
    return Reader{text, findings}.read();
}

}  // namespace aeolis::dictionary
