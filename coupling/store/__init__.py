"""What a run keeps on disk: folder, results, checkpoint and logs, in files that appear whole."""
