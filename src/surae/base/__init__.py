"""What every other room stands on: files, units, records, settings, words, errors."""
