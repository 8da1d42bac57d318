# Makes strings of the program out of the lexicon's data files.
file(READ ${FOLDER}/lexicon.txt lexicon)
file(READ ${FOLDER}/words.txt words)
file(WRITE ${OUTPUT}
  "// Text of the lexicon.\n#include \"engine/language/plan/words/lexicon_data.h\"\n"
  "namespace gse::language::plan {\n"
  "std::string_view lexicon_text() { return R\"lex(${lexicon})lex\"; }\n"
  "std::string_view words_text() { return R\"lex(${words})lex\"; }\n}\n")
