#pragma once
/// Reads the columns of a plain OpenSim storage file, for reference numbers of these tests only.

#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace brachium::tests {

inline std::map<std::string, std::vector<double>> read_storage(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("cannot read " + file);
  std::string line;
  while (std::getline(in, line) && line.rfind("endheader", 0) != 0) {
  }
  std::getline(in, line);
  std::vector<std::string> names;
  std::istringstream heads(line);
  for (std::string name; heads >> name;) names.push_back(name);
  std::map<std::string, std::vector<double>> table;
  while (std::getline(in, line)) {
    std::istringstream row(line);
    double value;
    for (std::size_t i = 0; i < names.size() && row >> value; ++i) table[names[i]].push_back(value);
  }
  return table;
}

}  // namespace brachium::tests
