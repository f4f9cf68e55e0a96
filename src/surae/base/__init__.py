"""What every other room stands on: files, units, records, words, errors."""
