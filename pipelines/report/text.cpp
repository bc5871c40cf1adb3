#include "pipelines/report/text.hpp"

#include <array>
#include <cctype>
#include <cstddef>
#include <utility>

namespace brachium::pipelines::report {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD

/// Length of the UTF-8 sequence at `i` if it is well formed (RFC 3629), else 0.
std::size_t utf8_length(std::string_view text, std::size_t i) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned char lead = byte(i);
  if (lead < 0x80) return 1;
  std::size_t length = 0;
  if (lead >= 0xC2 && lead <= 0xDF) length = 2;
  if (lead >= 0xE0 && lead <= 0xEF) length = 3;
  if (lead >= 0xF0 && lead <= 0xF4) length = 4;
  if (length == 0 || i + length > text.size()) return 0;
  for (std::size_t k = 1; k < length; ++k) {
    if ((byte(i + k) & 0xC0) != 0x80) return 0;
  }
  const unsigned char second = byte(i + 1);
  if (lead == 0xE0 && second < 0xA0) return 0;  // overlong
  if (lead == 0xED && second > 0x9F) return 0;  // surrogates
  if (lead == 0xF0 && second < 0x90) return 0;  // overlong
  if (lead == 0xF4 && second > 0x8F) return 0;  // above U+10FFFF
  return length;
}

bool starts_with_at(std::string_view text, std::size_t i, std::string_view prefix) {
  return text.substr(i, prefix.size()) == prefix;
}

/// End of a link that starts at `i`: up to white space or a quote, without the punctuation that ends a
/// sentence and without a closing bracket that was never opened inside (DOIs may contain brackets).
std::size_t link_end(std::string_view text, std::size_t i) {
  std::size_t end = i;
  int open = 0;
  for (; end < text.size(); ++end) {
    const char c = text[end];
    if (std::isspace(static_cast<unsigned char>(c)) || c == '"' || c == '<' || c == '>' || c == '`') break;
    if (c == '(') ++open;
    if (c == ')' && --open < 0) break;
  }
  while (end > i && std::string_view(".,;:!?'").find(text[end - 1]) != std::string_view::npos) --end;
  return end;
}

std::string link(std::string_view address_prefix, std::string_view target, std::string_view shown) {
  std::string href;
  for (const char c : target) {
    if (c == '%' || c == '#') {
      href += c == '%' ? "%25" : "%23";
    } else {
      href += c;
    }
  }
  return "<a href=\"" + std::string(address_prefix) + escape(href) + "\">" + escape(shown) + "</a>";
}

/// "R2" as a word of its own is the coefficient of determination.
std::string square_of_r(std::string text) {
  for (std::size_t at = text.find("R2"); at != std::string::npos; at = text.find("R2", at + 1)) {
    const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
    if ((at > 0 && is_word(text[at - 1])) || (at + 2 < text.size() && is_word(text[at + 2]))) continue;
    text.replace(at, 2, "R²");
  }
  return text;
}

}  // namespace

std::string escape(std::string_view text) {
  std::string out;
  out.reserve(text.size() + text.size() / 8);
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = utf8_length(text, i);
    if (length != 1) {
      out += length == 0 ? kReplacement : text.substr(i, length);
      i += length == 0 ? 1 : length;
      continue;
    }
    const char c = text[i++];
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default: {
        const bool control = (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t') || c == 0x7F;
        if (control) {
          out += kReplacement;
        } else {
          out += c;
        }
      }
    }
  }
  return out;
}

std::string bind_units(std::string_view text) {
  // Longer symbols first: "N m" before "N".
  static constexpr std::array<std::string_view, 26> kUnits = {
      "N m/rad", "N m", "rad/s", "deg/s", "m/s^2", "m/s", "µV", "uV", "mV", "Hz", "kHz", "ms", "min",
      "kg",      "mm",  "cm",    "rad",   "deg",   "MB",  "lb", "dB", "%",  "N",  "s",   "m",  "V"};
  const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    out += text[i];
    const bool after_number =
        std::isdigit(static_cast<unsigned char>(text[i])) && i + 2 < text.size() && text[i + 1] == ' ';
    if (!after_number) continue;
    for (const std::string_view unit : kUnits) {
      const std::size_t end = i + 2 + unit.size();
      if (!starts_with_at(text, i + 2, unit) || (end < text.size() && is_word(text[end]))) continue;
      const std::string set = typeset_unit(unit);
      out += (set.starts_with("°") ? "" : "\u202F") + set;
      i = end - 1;
      break;
    }
  }
  return out;
}

std::string inline_markup(std::string_view text) {
  std::string out;
  std::size_t plain = 0;  // start of the text not yet written
  const auto flush = [&](std::size_t end) {
    out += escape(square_of_r(bind_units(text.substr(plain, end - plain))));
  };
  for (std::size_t i = 0; i < text.size();) {
    const bool word_start = i == 0 || !std::isalnum(static_cast<unsigned char>(text[i - 1]));
    if (text[i] == '`') {
      const std::size_t close = text.find('`', i + 1);
      if (close != std::string_view::npos && close > i + 1) {
        flush(i);
        out += "<code>" + escape(text.substr(i + 1, close - i - 1)) + "</code>";
        i = plain = close + 1;
        continue;
      }
    } else if (word_start && starts_with_at(text, i, "doi:10.")) {
      const std::size_t end = link_end(text, i);
      flush(i);
      out += link("https://doi.org/", text.substr(i + 4, end - i - 4), text.substr(i, end - i));
      i = plain = end;
      continue;
    } else if (word_start && (starts_with_at(text, i, "https://") || starts_with_at(text, i, "http://"))) {
      const std::size_t end = link_end(text, i);
      flush(i);
      const std::string_view address = text.substr(i, end - i);
      // An address is kept as it is: its percent signs and fragment mean something.
      out += "<a href=\"" + escape(address) + "\">" + escape(address) + "</a>";
      i = plain = end;
      continue;
    }
    ++i;
  }
  flush(text.size());
  return out;
}

std::string typeset_unit(std::string_view unit) {
  static constexpr std::array<std::string_view, 10> kSuperscripts = {"⁰", "¹", "²", "³", "⁴",
                                                                     "⁵", "⁶", "⁷", "⁸", "⁹"};
  if (unit == "deg") return "°";
  if (unit == "deg/s") return "°/s";
  std::string out;
  for (std::size_t i = 0; i < unit.size(); ++i) {
    const char c = unit[i];
    if (c == '^') {
      for (++i; i < unit.size() && (std::isdigit(static_cast<unsigned char>(unit[i])) || unit[i] == '-');
           ++i) {
        out +=
            unit[i] == '-' ? std::string_view("⁻") : kSuperscripts[static_cast<std::size_t>(unit[i] - '0')];
      }
      --i;
    } else if (c == ' ' || c == '*') {
      out += "\u202F";  // narrow no-break space
    } else if (c == 'u' && i + 1 < unit.size() &&
               (unit[i + 1] == 'V' || unit[i + 1] == 's' || unit[i + 1] == 'm')) {
      out += "µ";
    } else {
      out += c;
    }
  }
  return out;
}

std::string typeset_label(std::string_view label) {
  if (label.empty() || label.back() != ']') return std::string(label);
  const std::size_t open = label.rfind('[');
  if (open == std::string_view::npos) return std::string(label);
  const std::string_view unit = label.substr(open + 1, label.size() - open - 2);
  if (unit == "1") return std::string(label.substr(0, open > 0 ? open - 1 : 0));
  return std::string(label.substr(0, open)) + "[" + typeset_unit(unit) + "]";
}

std::string in_words(std::string_view name) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 9> kWritten = {
      {{"r2", "R²"},
       {"rmse", "RMSE"},
       {"nrmse", "NRMSE"},
       {"rms", "RMS"},
       {"snr", "SNR"},
       {"emg", "EMG"},
       {"mvc", "MVC"},
       {"db", "dB"},
       {"hz", "Hz"}}};
  std::string out;
  while (!name.empty()) {
    const std::size_t end = name.find('_');
    std::string_view word = name.substr(0, end);
    for (const auto& [plain, written] : kWritten) {
      if (word == plain) word = written;
    }
    if (!out.empty() && !word.empty()) out += ' ';
    out += word;
    name = end == std::string_view::npos ? std::string_view() : name.substr(end + 1);
  }
  return out;
}

std::string label_of_name(std::string_view name, std::string_view unit) {
  // Longer endings first: "_kg_m" before "_m".
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 18> kEndings = {
      {{"_kg_m2", "kg m^2"},
       {"_kg_m", "kg m"},
       {"_N_m", "N m"},
       {"_rad_s", "rad/s"},
       {"_deg_s", "deg/s"},
       {"_m_s", "m/s"},
       {"_kg", "kg"},
       {"_rad", "rad"},
       {"_deg", "deg"},
       {"_Hz", "Hz"},
       {"_hz", "Hz"},
       {"_db", "dB"},
       {"_dB", "dB"},
       {"_uV", "uV"},
       {"_V", "V"},
       {"_N", "N"},
       {"_m", "m"},
       {"_s", "s"}}};
  std::string_view words = name;
  std::string_view found;
  for (const auto& [ending, symbol] : kEndings) {
    // A table states its units: "_m" at the end of a name without one means something else.
    if (!name.ends_with(ending) || unit == "1") continue;
    words = name.substr(0, name.size() - ending.size());
    found = symbol;
    break;
  }
  if (!unit.empty()) found = unit == "1" ? "" : unit;
  return in_words(words) + (found.empty() ? "" : " [" + std::string(found) + "]");
}

std::string plain_text(std::string_view text) {
  std::string out(text);
  std::erase(out, '`');
  return out;
}

std::string make_anchor(std::string_view title) {
  std::string out;
  for (const char c : title) {
    if (std::isalnum(static_cast<unsigned char>(c)) && static_cast<unsigned char>(c) < 0x80) {
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (!out.empty() && out.back() != '-') {
      out += '-';
    }
  }
  while (!out.empty() && out.back() == '-') out.pop_back();
  return out.empty() ? "section" : out;
}

}  // namespace brachium::pipelines::report
