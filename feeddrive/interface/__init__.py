"""The public interface: what `import feeddrive as fd` offers, one file per job."""
